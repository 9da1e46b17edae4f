// What the check of the archive must refuse: a product in float and two conversions.
int bait(float a, int b) {
  return static_cast<int>(a * static_cast<float>(b));
}
