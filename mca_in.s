.intel_syntax noprefix
movapd xmm2,XMMWORD PTR [rdi+0x480]
movapd xmm1,XMMWORD PTR [rdx+0x390]
movapd xmm0,XMMWORD PTR [rdx+0x380]
mov    r11,QWORD PTR [rsp+0x210]
movapd xmm3,XMMWORD PTR [rsp+0x1f0]
mulpd  xmm1,xmm2
sqrtpd xmm1,xmm1
mulpd  xmm1,XMMWORD PTR [rsp+0x250]
mulpd  xmm3,xmm1
mulpd  xmm0,xmm1
mulpd  xmm1,xmm15
mulpd  xmm3,xmm2
sqrtpd xmm0,xmm0
mulpd  xmm0,xmm14
movaps XMMWORD PTR [rdx+0x3f0],xmm1
mulpd  xmm0,XMMWORD PTR [rdx+0x370]
movapd xmm1,XMMWORD PTR [rsp+0x240]
mulpd  xmm1,xmm3
addpd  xmm0,xmm3
mulpd  xmm1,xmm2
movaps XMMWORD PTR [rdx+0x4c0],xmm1
movapd xmm1,xmm13
cmpltpd xmm1,xmm0
andpd  xmm0,xmm1
movapd xmm1,xmm0
movaps XMMWORD PTR [rdx+0x3e0],xmm0
subpd  xmm1,xmm3
mulpd  xmm1,XMMWORD PTR [rdx+0x370]
movaps XMMWORD PTR [rdx+0x4d0],xmm1
movsd  xmm1,QWORD PTR [r11+0x10]
unpcklpd xmm1,xmm1
mulpd  xmm0,xmm1
movaps XMMWORD PTR [rdx+0x400],xmm0
movapd xmm4,XMMWORD PTR [rcx]
movapd xmm6,XMMWORD PTR [rcx+0x10]
movapd xmm8,XMMWORD PTR [rdi+0x180]
movapd xmm7,XMMWORD PTR [rdi+0x300]
movapd xmm0,XMMWORD PTR [rcx+0x20]
movapd xmm1,XMMWORD PTR [rcx+0x30]
movapd xmm5,xmm4
movapd xmm3,xmm6
movapd xmm9,XMMWORD PTR [rdi]
movapd xmm2,xmm7
movapd xmm11,xmm8
unpcklpd xmm5,xmm0
unpckhpd xmm4,xmm0
unpcklpd xmm3,xmm1
mulpd  xmm2,xmm5
unpckhpd xmm6,xmm1
movapd xmm0,xmm8
mulpd  xmm0,xmm3
movapd xmm1,xmm7
movaps XMMWORD PTR [rdx+0x410],xmm6
mulpd  xmm1,xmm4
mulpd  xmm11,xmm5
subpd  xmm0,xmm1
movapd xmm1,xmm9
mulpd  xmm1,xmm3
mulpd  xmm0,XMMWORD PTR [rdx+0x3d0]
subpd  xmm2,xmm1
movapd xmm1,xmm9
mulpd  xmm1,xmm4
addpd  xmm0,xmm5
mulpd  xmm2,XMMWORD PTR [rdx+0x3d0]
mulpd  xmm5,xmm5
subpd  xmm1,xmm11
mulpd  xmm1,XMMWORD PTR [rdx+0x3d0]
addpd  xmm2,xmm4
mulpd  xmm4,xmm4
addpd  xmm1,xmm3
mulpd  xmm3,xmm3
addpd  xmm5,xmm4
movapd xmm4,xmm8
mulpd  xmm4,xmm2
addpd  xmm3,xmm5
mulpd  xmm6,xmm3
movaps XMMWORD PTR [rdx+0x430],xmm3
movapd xmm3,xmm9
mulpd  xmm3,xmm0
movaps XMMWORD PTR [rdx+0x440],xmm6
addpd  xmm3,xmm4
movapd xmm4,xmm7
mulpd  xmm4,xmm1
addpd  xmm3,xmm4
mulpd  xmm9,xmm3
mulpd  xmm8,xmm3
mulpd  xmm7,xmm3
subpd  xmm0,xmm9
subpd  xmm2,xmm8
subpd  xmm1,xmm7
movaps XMMWORD PTR [rdx+0x460],xmm0
mulpd  xmm0,xmm0
movaps XMMWORD PTR [rdx+0x470],xmm2
mulpd  xmm2,xmm2
movaps XMMWORD PTR [rdx+0x480],xmm1
mulpd  xmm1,xmm1
addpd  xmm0,xmm2
addpd  xmm0,xmm1
movaps XMMWORD PTR [rdx+0x420],xmm0
test   r8,r8
movapd xmm0,XMMWORD PTR [rdx+0x220]
mulpd  xmm0,XMMWORD PTR [rdx+0x240]
movapd xmm2,xmm10
movapd xmm1,XMMWORD PTR [rsp+0x190]
maxpd  xmm1,XMMWORD PTR [rdx+0x250]
movapd xmm3,xmm1
movaps XMMWORD PTR [rdx+0x280],xmm0
movapd xmm0,XMMWORD PTR [rsp+0x1a0]
maxpd  xmm0,XMMWORD PTR [rdx+0x220]
mulpd  xmm3,xmm0
divpd  xmm2,xmm3
mulpd  xmm1,xmm2
mulpd  xmm0,xmm2
mulpd  xmm0,XMMWORD PTR [rdx+0x260]
movaps XMMWORD PTR [rdx+0x240],xmm1
movapd xmm1,XMMWORD PTR [rdx+0x2a0]
sqrtpd xmm0,xmm0
mulpd  xmm1,xmm0
movaps XMMWORD PTR [rdx+0x2a0],xmm1
movapd xmm1,XMMWORD PTR [rdx+0x2b0]
mulpd  xmm1,xmm0
mulpd  xmm0,XMMWORD PTR [rdx+0x290]
movaps XMMWORD PTR [rdx+0x2b0],xmm1
movaps XMMWORD PTR [rdx+0x290],xmm0
cmp    r8,0x1
movapd xmm0,XMMWORD PTR [rdx+0x50]
movapd xmm1,xmm10
minpd  xmm1,XMMWORD PTR [rdx+0xb0]
movapd xmm2,XMMWORD PTR [rdx+0xc0]
movapd xmm4,XMMWORD PTR [rdx+0xd0]
mulpd  xmm0,xmm12
movapd xmm3,XMMWORD PTR [rdx+0xe0]
mulpd  xmm2,xmm1
mulpd  xmm4,xmm1
mulpd  xmm3,xmm1
movapd xmm1,XMMWORD PTR [rdx]
mulpd  xmm1,xmm0
addpd  xmm1,xmm2
movapd xmm2,xmm1
movaps XMMWORD PTR [rdx+0xf0],xmm1
mulpd  xmm2,xmm1
movapd xmm1,XMMWORD PTR [rdx+0x10]
mulpd  xmm1,xmm0
mulpd  xmm0,XMMWORD PTR [rdx+0x20]
addpd  xmm1,xmm4
addpd  xmm0,xmm3
movaps XMMWORD PTR [rdx+0x100],xmm1
mulpd  xmm1,xmm1
movaps XMMWORD PTR [rdx+0x110],xmm0
mulpd  xmm0,xmm0
addpd  xmm1,xmm2
addpd  xmm1,xmm0
movapd xmm0,XMMWORD PTR [rdx+0x60]
mulpd  xmm0,xmm0
movaps XMMWORD PTR [rdx+0x80],xmm1
cmpltpd xmm0,xmm1
movmskpd r11d,xmm0
test   r11d,r11d
setne  BYTE PTR [rbx+r8*1]
add    r8,0x1
cmp    r8,0x10
add    rdi,0x10
add    rdx,0x1d0
add    rcx,0x40
