"""The train as a twisted surface of true diameters: its bodies, the picture, and VTU."""
