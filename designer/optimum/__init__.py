"""The robot optimised: fields of a study as design variables, a result of it as the objective."""
