"""What can be done about pounding: measures between or in buildings of a street, compared by what they leave."""
