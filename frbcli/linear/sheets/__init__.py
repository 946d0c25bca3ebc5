"""Sheets of bearings."""
