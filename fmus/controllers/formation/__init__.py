"""What the followers of a formation share: ports, supervision of the link, realisation of speed and yaw rate."""
