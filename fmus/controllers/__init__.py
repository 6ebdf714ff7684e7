"""The controllers: reference trajectory, high-level tracking and low-level loops."""
