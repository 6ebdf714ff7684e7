"""What several families of scenarios use: sensors, starts, plans, errors of tracking, pages of pictures."""
