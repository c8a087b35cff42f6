#version 450
#include "../../../../README.md"
void main() {}
