"""What runs a checked system: slaves, their order, the master and its loop."""
