"""Virtual drivers beside real ones: the same quantities from recordings of people.

The recordings stay where the user keeps them; a folder is named by an argument or by
COSTEER_DATA. Without them the published values stand in.
"""
