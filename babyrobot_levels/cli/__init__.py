"""The command `babyrobot`: the only part that prints, and the only user of typer."""
