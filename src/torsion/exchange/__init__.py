"""What the program exchanges with other files: two results compared, tables of masses read, models written.

Nothing here computes a vibration; it reads results and files and hands on what they hold.
"""
