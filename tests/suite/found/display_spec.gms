* A display specification that does not fit.
parameter p(*,*) / a.b 1 /; option p:4:2:0; display p;
*! error 2
