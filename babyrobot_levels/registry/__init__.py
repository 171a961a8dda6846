"""What extensions add to the package: their manifests, and the tables that take it from them."""
