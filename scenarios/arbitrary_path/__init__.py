"""A road planned while it is driven."""
