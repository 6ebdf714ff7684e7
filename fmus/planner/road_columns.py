"""The columns of road files."""

COLUMNS = ("x", "y", "width_left", "width_right")
PUBLISHED = {"x_m": "x", "y_m": "y", "w_tr_right_m": "width_right", "w_tr_left_m": "width_left"}
"""The columns by the names that race tracks are published with, in their order, after a `#`."""
