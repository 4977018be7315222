* Literals beyond the limits are infinite, or 0.
scalar h / 1e300 /, k / 1e-300 /; display h, k;
*> ----      2 PARAMETER h                    =         UNDF
*>             PARAMETER k                    =          EPS
