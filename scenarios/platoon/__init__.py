"""Cars in a row: whether disturbances grow from car to car."""
