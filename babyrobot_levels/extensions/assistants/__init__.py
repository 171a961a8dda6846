"""What assistants that write levels are given: a page on the language, and tools."""
