"""Plans on meshes that follow the road and the plan: `planning.plan` is the entry. See fmus/planner/README.md."""
