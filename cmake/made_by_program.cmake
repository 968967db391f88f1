# Within `cmake --install`: fills the folder ${gear3k_made} with what ${gear3k_program} prints of itself: the pages
# of the manual, compressed without name and time, and the completion of bash.
file(REMOVE_RECURSE ${gear3k_made})
execute_process(COMMAND ${gear3k_program} manual --out ${gear3k_made}/man COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${gear3k_program} completion --out ${gear3k_made}/completion COMMAND_ERROR_IS_FATAL ANY)
file(GLOB pages ${gear3k_made}/man/*/*)
execute_process(COMMAND gzip -9n ${pages} COMMAND_ERROR_IS_FATAL ANY)
