"""The language as pydantic models: what each field may hold, and what must hold between them."""
