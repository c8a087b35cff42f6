#version 450
void main() {
#if AA
#endif
}
