"""Exact solutions of a level: optimal policies, values of given policies, simulations."""
