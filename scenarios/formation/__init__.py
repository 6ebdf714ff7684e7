"""Cars in formation: a head that tracks a trajectory, and followers that keep their places."""
