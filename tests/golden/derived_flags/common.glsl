#if F0 && F1
#define DERIVED0 1
#else
#define DERIVED0 0
#endif
#if F1 && F2
#define DERIVED1 1
#else
#define DERIVED1 0
#endif
#if F2 && F3
#define DERIVED2 1
#else
#define DERIVED2 0
#endif
#if F3 && F4
#define DERIVED3 1
#else
#define DERIVED3 0
#endif
#if F4 && F5
#define DERIVED4 1
#else
#define DERIVED4 0
#endif
#if F5 && F6
#define DERIVED5 1
#else
#define DERIVED5 0
#endif
#if F6 && F7
#define DERIVED6 1
#else
#define DERIVED6 0
#endif
#if F7 && F8
#define DERIVED7 1
#else
#define DERIVED7 0
#endif
#if F8 && F9
#define DERIVED8 1
#else
#define DERIVED8 0
#endif
#if F9 && F10
#define DERIVED9 1
#else
#define DERIVED9 0
#endif
#if F10 && F11
#define DERIVED10 1
#else
#define DERIVED10 0
#endif
#if F11 && F12
#define DERIVED11 1
#else
#define DERIVED11 0
#endif
#if F12 && F13
#define DERIVED12 1
#else
#define DERIVED12 0
#endif
#if F13 && F14
#define DERIVED13 1
#else
#define DERIVED13 0
#endif
#if F14 && F15
#define DERIVED14 1
#else
#define DERIVED14 0
#endif
#if F15 && F16
#define DERIVED15 1
#else
#define DERIVED15 0
#endif
#if F16 && F17
#define DERIVED16 1
#else
#define DERIVED16 0
#endif
#if F17 && F18
#define DERIVED17 1
#else
#define DERIVED17 0
#endif
#if F18 && F19
#define DERIVED18 1
#else
#define DERIVED18 0
#endif
#if F19 && F20
#define DERIVED19 1
#else
#define DERIVED19 0
#endif
#if F20 && F21
#define DERIVED20 1
#else
#define DERIVED20 0
#endif
#if F21 && F22
#define DERIVED21 1
#else
#define DERIVED21 0
#endif
#if F22 && F23
#define DERIVED22 1
#else
#define DERIVED22 0
#endif
#if F23 && F24
#define DERIVED23 1
#else
#define DERIVED23 0
#endif
#if F24 && F25
#define DERIVED24 1
#else
#define DERIVED24 0
#endif
#if F25 && F26
#define DERIVED25 1
#else
#define DERIVED25 0
#endif
#if F26 && F27
#define DERIVED26 1
#else
#define DERIVED26 0
#endif
#if F27 && F28
#define DERIVED27 1
#else
#define DERIVED27 0
#endif
#if F28 && F29
#define DERIVED28 1
#else
#define DERIVED28 0
#endif
#if F29 && F30
#define DERIVED29 1
#else
#define DERIVED29 0
#endif
#if F30 && F31
#define DERIVED30 1
#else
#define DERIVED30 0
#endif
#if F31 && F32
#define DERIVED31 1
#else
#define DERIVED31 0
#endif
#if F32 && F33
#define DERIVED32 1
#else
#define DERIVED32 0
#endif
#if F33 && F34
#define DERIVED33 1
#else
#define DERIVED33 0
#endif
#if F34 && F35
#define DERIVED34 1
#else
#define DERIVED34 0
#endif
#if F35 && F36
#define DERIVED35 1
#else
#define DERIVED35 0
#endif
#if F36 && F37
#define DERIVED36 1
#else
#define DERIVED36 0
#endif
#if F37 && F38
#define DERIVED37 1
#else
#define DERIVED37 0
#endif
#if F38 && F39
#define DERIVED38 1
#else
#define DERIVED38 0
#endif
#if F39 && F0
#define DERIVED39 1
#else
#define DERIVED39 0
#endif
