"""Collision avoidance: last points to brake and to steer, the decision, and the manoeuvre. Equations in README.md."""
