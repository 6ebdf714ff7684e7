"""Vehicle16Dof: the multibody car of 16 degrees of freedom. Equations and frames: README.md."""
