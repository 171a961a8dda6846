"""YAML as text: reading it with positions, and writing it, canonically or into what is there."""
