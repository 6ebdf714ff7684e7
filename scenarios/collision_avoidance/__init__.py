"""An obstacle appears: brake, steer, or both."""
