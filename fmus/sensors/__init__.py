"""Sensors: from the plant's true motion to what the controllers may see."""
