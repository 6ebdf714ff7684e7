"""The time-optimal double lane change of chapter 3, with MpcAllocator."""
