"""The assumed cars: their numbers, what follows from them, and the geometry all components share.

Every arrow is a function that takes the car above it, so that another car goes the same way as the nominal one.

    ../vehicle16dof/parameters.toml            single_track.toml, double_track.toml
          |  nominal.plant_values                    |  published.single_track
          |  multibody.assumed_car                   |  published.double_track
          v                                          v
    AssumedCar                                 the published car:
          |  derived.single_track              SingleTrackCar, DoubleTrackCar
          |  (its tyres fitted in axle_fit)
          v
    SingleTrackCar  --- grip.with_grip --->  the same on tyres with part of the grip
          |  derived.double_track
          v
    DoubleTrackCar

`nominal.DESIGN` is the one nominal car. Controllers and the filter take from it the start values of their parameters
`design.*` (`design_parameters`), and no more: simulated truth and assumed car stay separate. The published car gives
DoubleTrack, MpcAllocator and RecedingHorizonPlanner their start values. Only `derived` and `axle_fit` need NumPy and
SciPy, only `rotation` needs CasADi: what an interface imports stays light.
"""
