"""Events and faults that any system with their signals can have: `cosim run NAME --events gps-outage`."""
