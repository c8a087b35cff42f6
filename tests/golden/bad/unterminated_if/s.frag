#version 450
void main() {}
#if A
