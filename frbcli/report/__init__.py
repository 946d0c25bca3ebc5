"""One self-contained page about a run; jinja2 lives here only."""
