"""Several robots: one agent for each, and what each of them loses."""
