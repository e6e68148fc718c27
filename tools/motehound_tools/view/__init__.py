"""A page on localhost that shows a recording as it plays, served and drawn by Bokeh."""
