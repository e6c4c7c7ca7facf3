# Completion of flexarm and flexarmd in fish: the programs say what may follow.
function __flexarm_complete
    set -l words (commandline -opc) (commandline -ct)
    for word in ($words[1] --complete $words[2..-1] 2>/dev/null)
        switch $word
            case ':files'
                __fish_complete_path (commandline -ct)
            case ':folders'
                __fish_complete_directories (commandline -ct)
            case '*'
                echo $word
        end
    end
end
for program in flexarm flexarmd flexarm-study flexarm-web
    complete -c $program -f -a '(__flexarm_complete)'
end
