"""Where the editor is shown: a browser, by a server, and notebooks, as a widget."""
