"""The editor: a level's text changed by gestures, in a browser and in notebooks."""
