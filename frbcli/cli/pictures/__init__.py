"""What is made of a run: pictures, tables and pages."""
