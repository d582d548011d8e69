"""The figures of the paper, one module per figure.

Each module has ``table(data)``, the plotted numbers as they are written beside the figure, and
``draw(table)``, which draws them and computes nothing.
"""
