"""What a scenario is, what it does, and where scenarios are found."""
