"""Sheets of thrust bearings."""
