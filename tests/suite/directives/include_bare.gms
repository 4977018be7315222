$setGlobal bare 4
