"""Methods of assistance behind one interface; each composes controller stages."""
