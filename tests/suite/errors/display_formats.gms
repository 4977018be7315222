* Formats that no display has.
parameter p(*,*) / a.b 1 /, q(*) / a 1 /;  scalar s / 2 /;
option p:2:1:1, q:2:0:1, s:3;
option p:2:0:0;
option p:2:2:1;
option q:2:1:1;
option s:9;
*! error 4
*! error 5
*! error 6
*! error 7
