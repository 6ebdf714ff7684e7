"""How many rows the table has room for."""

ROWS = 5
