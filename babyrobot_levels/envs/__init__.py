"""Gymnasium environments of levels: single and vector ones, and adapters."""
