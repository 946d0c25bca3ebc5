"""Balances of heat of films, rings and walls. Knows neither how a film is solved nor a case."""
