"""Names of what the car has of energy [J], of what drives it and of where the power goes [W]."""

STORES = {
    "kinetic": "kinetic energy of all bodies",
    "gravity": "potential energy of all bodies above the height zero of the world",
    "elastic": "energy of springs, anti-roll bars, stops and tyres pressed on the road, zero at no travel in the air",
}
SOURCES = {
    "motors": "power of the motors",
    "steering": "power of the steering torques",
    "suspension": "power of the active suspension forces",
    "external": "power of body_force and body_moment",
}
SINKS = {
    "brakes": "power lost in the brakes",
    "tyres": "power that the tyres take by slipping and by turning on the spot; a little is held by their deflection",
    "rolling": "power lost to rolling resistance",
    "dampers": "power lost in the dampers of suspension and steering and in the tyres as vertical springs",
    "drag": "power lost to air drag",
}
